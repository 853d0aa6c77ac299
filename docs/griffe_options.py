"""For the reference: functions whose keywords come from the table of options are shown with all of them, and each
option of a dataclass with what its row says."""

from __future__ import annotations

import inspect
from typing import Any

import griffe

from remac_env.option_rows import rows, told


class OptionsInDocstrings(griffe.Extension):
    """Puts in the signature and the docstring that `remac_env.option_rows.takes_options` gives a function."""

    def on_function_instance(self, *, func: griffe.Function, **kwargs: Any) -> None:
        """Where the docstring says `{options}`, take both from the function as it is when it has been imported."""
        if func.docstring is None or "{options}" not in func.docstring.value:
            return
        made = griffe.dynamic_import(func.path)
        func.docstring.value = inspect.getdoc(made) or ""
        kinds = {kind.value: kind for kind in griffe.ParameterKind}
        func.parameters = griffe.Parameters(
            *(
                griffe.Parameter(
                    name,
                    kind=kinds[parameter.kind.description],
                    annotation=_said(parameter.annotation),
                    default=None if parameter.default is parameter.empty else repr(parameter.default),
                )
                for name, parameter in inspect.signature(made).parameters.items()
            )
        )


    def on_class_members(self, *, cls: griffe.Class, **kwargs: Any) -> None:
        """What the row of an option says becomes its docstring."""
        said = {name: each for name, each in cls.attributes.items() if str(each.value).startswith(("option(", "same("))}
        if not said:
            return
        for name, row in rows(griffe.dynamic_import(cls.path)).items():
            if name in said:
                said[name].docstring = griffe.Docstring(told(row), parent=said[name])


def _said(annotation: Any) -> str | None:
    if annotation is inspect.Parameter.empty:
        return None
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
