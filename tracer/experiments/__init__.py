"""Long measurements, which need no window: experiments, zoom tests, hunts for counterexamples, and sweeps."""
