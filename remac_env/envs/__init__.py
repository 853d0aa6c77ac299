"""The kitchens as Gymnasium and PettingZoo have them: in rounds, by events, one robot after the other."""
