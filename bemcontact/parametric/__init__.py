"""Contact states under linear changes of gap and load: derivatives, sensitivities, paths."""
