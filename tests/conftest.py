"""Every run of the tests tries the same random examples, so that a failure is the change's and not the day's."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
