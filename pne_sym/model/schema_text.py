"""What every field of a specification means, as editors show it beside the field."""

from __future__ import annotations

MEANING: dict[str, dict[str, str]] = {
    "specification": {
        "name": "Of files, modules and prefixes: a lower-case letter, then lower-case letters, "
        "digits, single underscores; no reserved word.",
        "title": "One line for people. Default: the name.",
        "space": "Task space: point (x, y), planar (x, y, phi), spatial (x, y, z, quaternion with "
        "the scalar last), translational (x, y, z), spherical (quaternion).",
        "gravity": "Acceleration in the base frame, m/s^2. Default: 9.81 downwards, along -z, in "
        "the plane along -y.",
        "moving_base": "The base moves: functions take its motion, gravity is in world axes.",
        "coupling": "A row of numbers for each motor: its angle, before the gear, per displacement "
        "of every actuated joint, in the order of tau. The matrix has an inverse.",
        "fixed_centre": "Space spherical only: the point about which the platform turns, base "
        "frame, m.",
        "platform": "Mass, centre of mass and inertia of the platform, platform frame.",
        "leg_types": "Joints and platform joints that legs share, by name.",
        "legs": "The legs; their order is that of q, of the actuators and of constraint forces.",
        "home": "A pose at which the loops close; it selects the assembly branch.",
        "symbols": "How the report writes quantities: name in the generated code = symbol.",
    },
    "body": {
        "mass": "kg; zero is allowed.",
        "centre_of_mass": "In the body's frame, m. Default: its origin.",
        "inertia": "kg m^2, body axes: a tensor by rows, [ixx, iyy, izz], a table of components, "
        "or in the plane the number izz. ixy = -integral of x y dm.",
        "inertia_about": "The point that the inertia is about. Default: centre_of_mass.",
    },
    "platform": {
        "payload": "A second body fixed in the platform, in its frame; parameters of its own.",
    },
    "joint": {
        "name": "What the joint is called in code and report; at most 20 characters. Of U, C, S "
        "one name is numbered, a list has one for each degree of freedom. Default: its number.",
        "kind": "R revolute, P prismatic, H helical, U universal, C cylindrical, S spherical.",
        "axis": "Unit vector in the preceding link's frame, or a direction such as x or -z.",
        "axes": "Of U (two) and S (three): unit vectors, each perpendicular to the next.",
        "offset": "From the preceding joint (the first: from base_point), preceding link's frame, "
        "m.",
        "pitch": "Of H: advance per angle, m/rad.",
        "actuated": "Actuated; of several degrees of freedom a list, one entry for each.",
        "extra": "The displacement is a coordinate of its own, appended to X.",
        "link": "Inertia of the link that the joint moves, link frame. Default: massless.",
        "friction": "Viscous and Coulomb friction, of passive joints too. Of U and S one table is "
        "meant for every degree of freedom, a list has a table or false for each; C needs a list.",
        "spring": "A spring between the links. U, C, S: as friction.",
        "actuator": "The motor of an actuated joint. Of U, C, S one table is meant for every "
        "actuated degree of freedom, a list has a table or false for each.",
        "limits": "What the joint may do; it does not act on it. U, C, S: as friction.",
    },
    "friction": {
        "viscous": "Friction per rate, N m s/rad, of prismatic joints N s/m.",
        "coulomb": "Friction at high rates v, N m, of prismatic joints N: times v / sqrt(v^2 + "
        "velocity_scale^2).",
        "velocity_scale": "Rate below which Coulomb friction grows linearly, rad/s, of prismatic "
        "joints m/s.",
    },
    "spring": {
        "stiffness": "N m/rad, of prismatic joints N/m.",
        "rest": "Displacement without force, rad, of prismatic joints m. Default: 0.",
    },
    "actuator": {
        "rotor_inertia": "Of all that turns with the motor, about its axis, kg m^2.",
        "gear_ratio": "Motor angle per displacement, of prismatic joints rad/m; negative where it "
        "turns the other way.",
    },
    "limits": {
        "displacement": "Least and largest, rad, of prismatic joints m.",
        "rate": "Largest size, rad/s, of prismatic joints m/s.",
        "effort": "Largest size of the actuator's torque, N m, of prismatic joints force, N.",
    },
    "platform_joint": {
        "kind": "S spherical, R revolute, U universal, rigid; in the plane R or S.",
        "offset": "Its place in the last link's frame, m.",
        "axis_link": "R, U in space: axis fixed in the last link, last link's frame.",
        "axis_platform": "R, U in space: axis fixed in the platform, platform frame.",
        "rotation": "rigid: platform axes in the last link's frame.",
        "friction": "Against the turning of the platform relative to the last link.",
    },
    "leg_type": {
        "joints": "From the base to the platform.",
        "platform_joint": "The joint that closes the leg: its kind alone, or a table.",
    },
    "leg": {
        "type": "Name of a leg type.",
        "name": "What the leg is called in code, report and messages; at most 20 characters. "
        "Default: its number.",
        "base_point": "Where the leg starts, base frame, m.",
        "base_frame": "Rotation from leg to base axes: its columns are the leg's axes; or rpy.",
        "joints": "From the base to the platform; or, with a type, fields that differ: "
        "joints.0.link.mass = 1.5",
        "platform_joint": "The joint that closes the leg, or fields that differ from the type's.",
        "platform_point": "Where the platform joint sits, platform frame, m.",
    },
    "home": {
        "X": "Platform coordinates, then those of the joints marked extra.",
        "q": "Displacements of all joints, flat or a list for each leg. Default: found from X.",
    },
    "rotation": {
        "rpy": "Roll, pitch, yaw about the fixed axes x, y, z, rad.",
        "rpy_deg": "Roll, pitch, yaw about the fixed axes x, y, z, degrees.",
    },
}
