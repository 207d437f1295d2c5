"""gravity_model: the wrench that gravity puts on the sensor, and its identification."""
