"""The yardstick: one mole at a time, error-controlled from event to event. Read `propagation`."""
