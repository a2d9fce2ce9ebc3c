"""The report's standing texts: laws, notation, conventions, methods, cases of the paper."""

from __future__ import annotations

from pne_sym.derivation import Law

LAWS: dict[Law, str] = {
    Law.DEFINITION: "A name for an expression that is used again.",
    Law.GEOMETRY: "Where points and axes are, from the geometry of the links.",
    Law.LOOP_CLOSURE: "The leg reaches from its base point to its connection point.",
    Law.RATE: "Derivative with respect to time of vectors that turn with their bodies.",
    Law.RECIPROCITY: "A vector is resolved along the joints' velocity vectors by the vectors "
    "reciprocal to them.",
    Law.NEWTON: "Newton: the forces on a body sum up to its mass times the acceleration of its "
    "centre of mass (Eq. 1).",
    Law.EULER: "Euler: the moments on a body sum up to the rate of its angular momentum (Eq. 2).",
    Law.FREEDOM: "Only the component of the equilibrium along the axis of a joint is kept: "
    "moment about the axis (R), force along it (P), both (H). Joint reactions have none "
    "(Sec. 2.2).",
    Law.REDUCTION: "The equilibria along all degrees of freedom of the leg, solved for the force "
    "at the connection point (Eq. 3).",
    Law.RULES: "The acceleration of the platform is collected by Rules I and II (Sec. 2.3, Eq. 4).",
    Law.ASSEMBLY: "Newton's and Euler's equations of the platform, with the forces of all legs "
    "(Sec. 2.4, Eq. 5).",
    Law.FRICTION: "Viscous friction grows with the rate; Coulomb friction is of constant size, "
    "smooth near rest. It takes power from every joint that has it.",
    Law.SPRING: "Hooke: the force is proportional to the displacement from that at rest.",
    Law.ROTOR: "A rotor geared to its joint: its inertia counts with the square of the ratio.",
    Law.COUPLING: "Gears and couplings take no power: forces are transformed by the transpose of "
    "the matrix that transforms rates.",
    Law.MOVING_FRAME: "Relative to a base that turns, bodies have Coriolis's, Euler's and "
    "centrifugal acceleration besides.",
    Law.LIMIT: "How far a joint may go; nothing acts on it there.",
    Law.ENERGY: "Work of the weight.",
    Law.LUMPING: "A value made of parameters alone, computed once when they are set.",
}

MARKS: tuple[tuple[str, str], ...] = (
    (r"\mathbf a,\ \mathbf T,\ a", "vector, tensor (both bold), scalar"),
    (r"\dot{\mathbf a},\ \ddot{\mathbf a}", "first and second derivative with respect to time"),
    (r"\mathbf a\cdot\mathbf b", "scalar product"),
    (r"\mathbf a\times\mathbf b", "cross product"),
    (r"\lVert\mathbf a\rVert", "length of a vector"),
    (
        r"\tilde{\mathbf a}",
        r"tensor of the cross product, $`\tilde{\mathbf a}\,\mathbf b=\mathbf a\times\mathbf b`$",
    ),
    (
        r"\mathbf a\,\mathbf b^{\mathsf T}",
        (
            r"tensor product, $`(\mathbf a\,\mathbf b^{\mathsf T})\,\mathbf c"
            r"=\mathbf a\,(\mathbf b\cdot\mathbf c)`$"
        ),
    ),
    (r"\mathbf T^{\mathsf T},\ \mathrm{tr}(\mathbf T)", "transposed tensor, trace"),
    (r"\mathbf E", "identity tensor"),
    (
        r"\mathrm{ax}(\mathbf T)",
        r"axial vector, components $`T_{32}-T_{23},\ T_{13}-T_{31},\ T_{21}-T_{12}`$",
    ),
    (
        r"x^{\circ}",
        (
            r"remainder of $`x`$: its value at zero acceleration of the platform, "
            r"$`\mathbf a_p=\mathbf 0`$ (and at zero acceleration of extra coordinates)"
        ),
    ),
    (
        r"\sum_i",
        (
            "sum over the legs of a type (every type has its letter); quantities of a leg carry "
            "the index there, and none in the chapters on one leg"
        ),
    ),
)

SCREWS = (
    r"Column j of $`\mathcal V`$ says how joint j moves the connection point, and how it turns the "
    r"link along the directions of the moments that the platform joint transmits. Of row k of the "
    r"inverse, $`\mathrm F`$ is the part for the point (a vector), $`\mathrm M_i`$ that for moment "
    "direction i."
)

CONVENTIONS: tuple[str, ...] = (
    "SI units and radians; right-handed axes; the base is fixed.",
    (
        "Vectors and tensors are free of coordinates. Where numbers are meant (entries of X, V, A, "
        "M, Z, H, wrenches), components are taken in base axes."
    ),
    "Linear parts stand before angular ones. Moments are taken about the platform origin.",
    (
        "Legs and joints are numbered from 1, joints from the base outwards; link j is moved by "
        "joint j, link 0 is the base."
    ),
    (
        r"Gravity is an acceleration vector $`\mathbf g`$; it points downwards where the base "
        "stands upright."
    ),
    (
        r"An actuator's $`\tau`$ is conjugate to its joint's displacement and acts on the distal "
        "link: a force that extends a prismatic joint, a torque about the axis of a revolute or "
        "helical one."
    ),
    "The force of a leg is the force that the leg exerts on the platform at the connection point.",
    (
        'Equation numbers are those of the comments in the generated code. "Eq." and "Sec." refer '
        "to the paper."
    ),
)

METHODS: dict[str, str] = {
    "linear": "closed form. A direction fixed in link {j} keeps its scalar product with the vector "
    "to the connection point whatever the joints beyond do (they turn about it, or slide across "
    "it); that is one equation for this joint alone",
    "sphere": "closed form. The joints beyond turn about one centre, so the distance from there to "
    "the connection point is fixed; that is one equation for this joint alone",
    "direct": "closed form. No joint is left beyond it: read off the vector to the connection "
    "point",
    "orientation": "closed form. Its turning does not move the connection point; it shows in the "
    "right angle that the platform joint keeps between its two axes",
    "given": "nothing to solve: the displacement is an extra coordinate, an entry of X",
    "numeric": "no closed form, found by iteration on the leg's loop closure{reason}",
}

FUNCTIONS = {
    "dynamics": "all of the equation of motion together",
    "M": "mass matrix",
    "Z": "velocity and gravity terms",
    "H": "effect of the actuators",
    "Hk": "effect of the constraints",
    "constraint_bias": "velocity part of the constraints' second derivative",
    "required": "inverse dynamics: both sides of its linear system",
    "inverse_kinematics": "joint displacements",
    "joint_rates": "joint rates",
    "joint_accelerations": "joint accelerations",
    "constraints": "loop-closure residuals along the constraint wrenches",
    "legs": "leg forces, for the leg reactions",
    "potential": "potential energy",
    "dissipation": "power that friction takes",
    "motors": "rates of the motors, and the inverses of their ratios",
    "joint_margins": "distances of the joints from their limits",
    "effort_limits": "largest forces of the actuators",
    "condition": "H and the least pivots, for the conditioning",
}
SPACES = {
    "point": "a point moving in the plane",
    "planar": "a platform moving in the plane",
    "spatial": "a platform that moves and turns in space",
    "translational": "a platform that moves in space without turning",
    "spherical": "a platform that turns about a fixed centre",
}

CASES: dict[str, str] = {
    "3.1": "Ordinary (Sec. 3.1): as many actuators as degrees of freedom, at most one in a leg. "
    "Forces of the actuators and motion of the platform determine each other; H is square.",
    "3.2": "Hybrid (Sec. 3.2): a leg has several actuators; it has as many columns in H.",
    "3.3": "Static redundancy (Sec. 3.3): more legs than degrees of freedom. Actuators can work "
    "against each other; a leg without one is moved along, and counts in M and Z alone.",
    "3.4": "Redundant actuation (Sec. 3.4): more actuators than degrees of freedom, since joints "
    "that could be passive are actuated. Forces can be shared; H has more columns than rows.",
    "3.5": "Kinematic redundancy (Sec. 3.5): actuated joints that can move while the platform "
    "stands. Extra coordinates tell how they do, with equations of their own (Eq. 6).",
    "3.6": "Passive degrees of freedom (Sec. 3.6): passive joints that can move while the platform "
    "stands, such as a leg that spins about itself. Their displacements are extra coordinates, "
    "with equations of their own (Eq. 7).",
    "3.7": "Constrained (Sec. 3.7): legs keep the platform from moving in some directions. It has "
    "fewer degrees of freedom than coordinates; the reactions along these directions are the "
    "multipliers (Eqs. 35 to 37).",
}
