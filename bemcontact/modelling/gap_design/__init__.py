"""Design of initial gaps: the profile of a rigid surface that makes contact pressure low or uniform."""
