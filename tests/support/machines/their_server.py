"""A UM-Bridge server written with its own package, in a process of its own."""

import socket
import subprocess
import sys
from pathlib import Path
from textwrap import indent

_TEXT = """
import sys
import time
import umbridge

class Theirs(umbridge.Model):
    def __init__(self):
        super().__init__({name!r})
    def get_input_sizes(self, config):
        return {inputs}
    def get_output_sizes(self, config):
        return {outputs}
    def supports_evaluate(self):
        return True
    def __call__(self, parameters, config):
{body}

umbridge.serve_models([Theirs()], int(sys.argv[1]))
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class TheirServer:
    """A server of one model, which can be killed and started again; a context manager.

    Parameters
    ----------
    folder : Path
        For its source.
    body : str
        Lines that make a list of vectors of ``parameters``, another one.
    name : str
    inputs, outputs : list of int
        Sizes of vectors.
    """

    def __init__(self, folder, body, name="forward", inputs=(1,), outputs=(1,)):
        self._file, self._port = Path(folder) / "their_server_source.py", free_port()
        sizes = {"inputs": list(inputs), "outputs": list(outputs)}
        self._file.write_text(_TEXT.format(name=name, body=indent(body, 8 * " "), **sizes))
        self.base = f"http://127.0.0.1:{self._port}"
        self.address = f"{self.base}/{name}"
        self.process = None

    def start(self):
        """Start it; it answers a moment later."""
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        command = [sys.executable, str(self._file), str(self._port)]
        self.process = subprocess.Popen(command, **quiet)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *exception):
        self.kill()
