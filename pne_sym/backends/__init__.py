"""Back ends: NumPy, C, report and manifest, from the same compiled manipulator."""
