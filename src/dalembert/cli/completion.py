"""``dalembert completion``: what shells need to complete commands and options."""

from __future__ import annotations

from typing import Literal

from dalembert.cli.console import DONE

SHELLS = ("bash", "zsh", "fish")
"""Shells there is a script for."""


def completion(shell: Literal["bash", "zsh", "fish"], /) -> int:
    """Print the completion script of a shell.

    bash: dalembert completion bash > ~/.local/share/bash-completion/completions/dalembert

    zsh: dalembert completion zsh > a folder of $fpath, as _dalembert

    fish: dalembert completion fish > ~/.config/fish/completions/dalembert.fish

    Parameters
    ----------
    shell
        bash, zsh or fish.
    """
    from dalembert.cli.app import make_app

    print(make_app().generate_completion(shell=shell))
    return DONE
