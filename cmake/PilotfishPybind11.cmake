# pybind11 of the Python that the modules are for: the wheel in that Python's environment.
find_package(Python REQUIRED COMPONENTS Interpreter Development.Module)
if(NOT pybind11_DIR)
  execute_process(COMMAND ${Python_EXECUTABLE} -m pybind11 --cmakedir OUTPUT_VARIABLE pybind11_DIR
                  OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "no pybind11 in ${Python_EXECUTABLE}: run scripts/setup, then "
                        "cmake --preset release -D Python_EXECUTABLE=.venv/bin/python")
  endif()
endif()
find_package(pybind11 2.12 REQUIRED CONFIG)
