# The three shapes of target in this project. DEPS name the layers a target may include: a header that is not reached through them
# does not compile, which is how the rules of CONTRIBUTING.md ("The rooms") are kept.
#
# A library sees its dependencies' folders only: each library's include root is a folder of links to the rooms it owns.

# coach_library(<name> ROOM <folder> SOURCES ... DEPS ...)
function(coach_library name)
  cmake_parse_arguments(ARG "" "ROOM" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  # Only <build>/rooms/<name>/<room> is visible: a symbolic link to the room's folder.
  set(root ${PROJECT_BINARY_DIR}/rooms/${name})
  get_filename_component(parent ${ARG_ROOM} DIRECTORY)
  file(MAKE_DIRECTORY ${root}/${parent})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${ARG_ROOM} ${root}/${ARG_ROOM} SYMBOLIC)
  target_include_directories(${name} PUBLIC ${root})
  target_link_libraries(${name} PUBLIC ${ARG_DEPS} PRIVATE coach_warnings ${ARG_PRIVATE_DEPS})
endfunction()

# coach_program(<name> SOURCES ... DEPS ...): installed, with a man page from its --help.
function(coach_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE coach_warnings ${ARG_DEPS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME)
  set_property(GLOBAL APPEND PROPERTY COACH_PROGRAMS ${name})
endfunction()

# coach_test(<folder/name> SOURCES ... DEPS ... [TIMEOUT s]): one gtest executable, one ctest entry.
function(coach_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPS" ${ARGN})
  string(REPLACE "/" "_" target test_${name})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE coach_warnings ${ARG_DEPS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE COACH_SOURCE_DIR="${PROJECT_SOURCE_DIR}" COACH_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${target})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(COACH_SANITIZE)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} SKIP_RETURN_CODE 77)
endfunction()
