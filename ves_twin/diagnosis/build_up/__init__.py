"""Building up: as many causes as held-out data prove, against noise and model error."""
