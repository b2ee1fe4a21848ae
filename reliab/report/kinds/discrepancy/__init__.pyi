from .report import discrepancy_report as discrepancy_report
