"""Whatever someone else's code hands over, as text that can be shown and written: see `remac_env.quoting`."""

from remac_env.quoting import PATH, SHOWN, is_printable, printable, quoted, type_name, words

__all__ = ["PATH", "SHOWN", "is_printable", "printable", "quoted", "type_name", "words"]
