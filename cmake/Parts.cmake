# The parts of mjdiag that a program can ask for, find_package(mjdiag COMPONENTS ...), in
# the order in which they build on each other, and what each of them needs directly.
set(mjdiag_all_parts signals diagnosis plugin discovery studies render report c)
set(mjdiag_diagnosis_needs signals)
set(mjdiag_plugin_needs diagnosis)
set(mjdiag_discovery_needs plugin)
set(mjdiag_studies_needs discovery)
set(mjdiag_render_needs plugin)
set(mjdiag_report_needs studies)
