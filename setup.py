"""Tells catkin where the Python packages lie; pip reads pyproject.toml instead."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import find_packages, setup

setup(
    **generate_distutils_setup(
        packages=find_packages("src"),
        package_dir={"": "src"},
        package_data={
            "robotteamsim": ["py.typed"],
            "robotteamsim.analysis.benchmark": ["*.html"],
            "robotteamsim.analysis.report": ["*.html"],
            "robotteamsim.view": ["page/*"],
        },
    )
)
