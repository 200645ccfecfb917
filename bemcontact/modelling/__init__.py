"""Contact as something one composes: a condensed contact as a model in cvxpy, and the design of gaps with it."""
