"""Contact: shapes that touch, laws of how they press, rub and bounce."""
