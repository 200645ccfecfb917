"""A local solver for quadratic programs of any inertia; it knows nothing of contact."""
