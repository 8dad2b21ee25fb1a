"""Light at points: sensors, and what they measure."""
