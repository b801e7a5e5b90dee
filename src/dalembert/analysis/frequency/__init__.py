"""Linear systems about an operating point: frequency response and random vibration."""
