"""What the payload weighs, how that is found, and what errors of it do."""
