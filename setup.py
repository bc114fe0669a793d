"""Tells catkin where the Python package lies; pip reads pyproject.toml instead."""

from catkin_pkg.python_setup import generate_distutils_setup
from distutils.core import setup

setup(**generate_distutils_setup(packages=["robotteamsim"], package_dir={"": "src"}))
