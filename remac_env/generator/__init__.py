"""Tasks without number: drawn from templates, certified, and graded by the length of their shortest known plans."""

from remac_env.generator import index
from remac_env.generator.certified import Certified, scene_of
from remac_env.generator.making import GRADES, make

__all__ = ["GRADES", "Certified", "index", "make", "scene_of"]
