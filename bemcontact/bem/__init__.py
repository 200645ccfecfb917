"""The boundary-element core: a `Problem` in, a `CondensedContact` out; plane elastostatics, quadratic elements."""
