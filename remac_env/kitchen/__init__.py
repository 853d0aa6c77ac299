"""The kitchens: floor plans, fixtures, objects and styles."""
