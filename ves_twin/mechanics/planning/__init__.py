"""planning: dynamics of an arm on a flexible base, and the algorithms that plan with it."""
