"""Detect compilation by numba, which may take a while."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType, SimpleNamespace
from typing import Any


@contextmanager
def compilation(
    began: Callable[[], object], ended: Callable[[], object] = lambda: None
) -> Iterator[None]:
    """Call functions whenever numba starts and ends compiling in this process.

    Parameters
    ----------
    began, ended : callable
        Called in the thread that compiles; loading from the cache does not count.
    """
    with ExitStack() as stack:

        def listen() -> None:
            from numba.core import event

            class Compilation(event.Listener):
                depth = 0

                def on_start(self, event: Any) -> None:
                    self.depth += 1
                    if self.depth == 1:
                        began()

                def on_end(self, event: Any) -> None:
                    self.depth -= 1
                    if self.depth == 0:
                        ended()

            stack.enter_context(event.install_listener("numba:compile", Compilation()))

        if "numba" in sys.modules:
            listen()
        else:  # a model may import it when it computes its first rows
            stack.callback(when_imported("numba", listen))
        yield


def when_imported(name: str, action: Callable[[], object]) -> Callable[[], None]:
    """Call `action` once a module has been imported; return a function that cancels this."""

    def find(fullname: str, *arguments: Any) -> ModuleSpec | None:
        if fullname != name:
            return None
        sys.meta_path.remove(finder)  # the finders after it find the module
        try:
            spec = find_spec(name)
        finally:
            sys.meta_path.insert(0, finder)  # the spec may be asked for without an import
        if spec and spec.loader:
            execute = spec.loader.exec_module

            def execute_then_act(module: ModuleType) -> None:
                forget()
                execute(module)
                action()

            spec.loader.exec_module = execute_then_act  # type: ignore[method-assign]
        return spec

    def forget() -> None:
        if finder in sys.meta_path:
            sys.meta_path.remove(finder)

    finder: Any = SimpleNamespace(find_spec=find)
    sys.meta_path.insert(0, finder)
    return forget
