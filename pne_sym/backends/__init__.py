"""Back ends: NumPy, C, arrays of any library, report and manifest, from one compiled manipulator.

`registry` says what each is to the others, `emission` lets them print.
"""
