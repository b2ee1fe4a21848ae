from .report import rig_report as rig_report
