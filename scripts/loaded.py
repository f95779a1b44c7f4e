# SPDX-License-Identifier: Apache-2.0
"""Loads a script without the suffix .py as a module, for the script's test."""
import importlib.machinery
import importlib.util
import pathlib


def loaded(name):
    loader = importlib.machinery.SourceFileLoader(name, str(pathlib.Path(__file__).with_name(name)))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module
