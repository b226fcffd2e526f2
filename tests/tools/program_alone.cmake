# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DNINJA=… -DBUILD=… -P program_alone.cmake: what `ninja thalweg` makes holds the scripts that the program calls.
execute_process(COMMAND ${NINJA} -C ${BUILD} -t graph thalweg OUTPUT_VARIABLE made COMMAND_ERROR_IS_FATAL ANY)
foreach(script fetch/thalweg_fetch.py fetch/catalogue.toml figures/thalweg_figures.py figures/report.css)
  if(NOT made MATCHES "\"share/thalweg/${script}\"")
    message(FATAL_ERROR "the target thalweg does not bring share/thalweg/${script}")
  endif()
endforeach()
