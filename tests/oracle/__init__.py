"""Reference dynamics of parallel manipulators, independent of the generator.

Nothing in this package imports the generator's engine: it shares only the frozen
dataclasses that describe a manipulator.  Two oracles that have no code in common
beyond the description and the coordinates:

* `projection`: positions and rotations of all bodies, differentiated exactly in time
  (`jets`), then d'Alembert's principle;
* `pinocchio_model`: the dynamics of the tree of bodies by Pinocchio, projected on the
  loop closures.

`specs` reads a full form, and draws random geometry and random states.
"""
