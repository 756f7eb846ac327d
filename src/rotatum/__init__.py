"""Stiffness of elastic robot joints, estimated while they move, from the sensors they have.

>>> import rotatum as rt
>>> rt.device_names()[0]
'cjt-orange-80-6000'
"""

import lazy_loader as _lazy

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules={"datasets", "testing"},
    submod_attrs={
        "errors": ["RotatumError"],
        "estimators": ["Estimator", "StateObserver"],
        "evaluation": [
            "Characterisation",
            "Comparison",
            "Estimate",
            "Recommendation",
            "characterise",
            "compare",
            "estimate",
            "observe",
            "recommend",
        ],
        "export": ["export_c"],
        "logs": ["Log", "LogReader", "open_log", "read_log", "write_table"],
        "models": ["Device", "Joint", "cartesian_stiffness", "device_names", "load_device"],
        "report": ["plot", "plot_comparison", "write_comparison", "write_report"],
        "runtime": ["Bank", "Stage"],
        "simulation": [
            "Effects",
            "Payload",
            "Scenario",
            "Sensors",
            "demo_log",
            "load_scenario",
            "scenario_names",
            "simulate",
            "simulate_joint",
        ],
    },
)
