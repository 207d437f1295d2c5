"""VES II as the diagnosis sees it: forward model, library, noise, inputs and comparison."""
