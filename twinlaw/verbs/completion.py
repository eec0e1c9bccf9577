"""Print the script that completes twinlaw's verbs and options in your shell.

    source <(twinlaw completion bash)                                        # bash, in ~/.bashrc
    twinlaw completion zsh > ~/.zfunc/_twinlaw                               # zsh, with ~/.zfunc in fpath before compinit
    twinlaw completion fish > ~/.config/fish/completions/twinlaw.fish        # fish

The script starts no Python: print it anew after an update.
"""

import argparse

from twinlaw.cli.completion import SHELLS, command_tree, completion_text
from twinlaw.verbs import VERBS, build_parser


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """SHELL."""
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help=" or ".join(SHELLS))


def run(chosen: argparse.Namespace) -> int:
    """Print."""
    print(completion_text(command_tree(build_parser(tuple(VERBS))), chosen.shell), end="")
    return 0
