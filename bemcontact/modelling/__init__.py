"""Contact as a model in cvxpy, and the design of initial gaps with it."""
