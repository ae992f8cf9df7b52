# The man page of `rt COMMAND`, or of rt: cmake -DHELP2MAN=… -DRT=… -DCOMMAND=… -DVERSION=… -DOUTPUT=rt.1 -P; makes rt.1.gz.
# Its NAME is the first clause of the help.
execute_process(COMMAND ${RT} ${COMMAND} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^[^.;:\n]*" name "${help}")
get_filename_component(folder ${OUTPUT} DIRECTORY)
file(MAKE_DIRECTORY ${folder})
set(ENV{SOURCE_DATE_EPOCH} 0)
set(called ${RT} ${COMMAND})
list(JOIN called " " called)
execute_process(COMMAND ${HELP2MAN} --no-info --no-discard-stderr --name "${name}" --version-string ${VERSION}
                        --output ${OUTPUT} ${called}
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND gzip -9nf ${OUTPUT} COMMAND_ERROR_IS_FATAL ANY)
