# coach_add_lcm_types(<target> PACKAGE <package>): every <type>.lcm of this folder -> header-only <target>, and <target>-jar for
# lcm-spy when a JDK is found. Generated headers are SYSTEM, so they are free of our warnings.
function(coach_add_lcm_types target)
  cmake_parse_arguments(ARG "" "PACKAGE" "" ${ARGN})
  set(cpp_dir ${CMAKE_CURRENT_BINARY_DIR}/cpp)
  set(java_dir ${CMAKE_CURRENT_BINARY_DIR}/java)
  file(GLOB inputs CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.lcm)
  foreach(in IN LISTS inputs)
    get_filename_component(type ${in} NAME_WE)
    # lcm-gen 1.3.1 bounds the length of a string from above only: one of -2^31 would be read as 2^31 bytes.
    add_custom_command(OUTPUT ${cpp_dir}/${ARG_PACKAGE}/${type}.hpp
      COMMAND ${LCM_GEN} --cpp --cpp-std c++11 --cpp-hpath ${cpp_dir} ${in}
      COMMAND sed -i -E "s/if\\((__[a-z0-9_]+) > maxlen - pos\\)/if(\\1 < 1 || \\1 > maxlen - pos)/" ${cpp_dir}/${ARG_PACKAGE}/${type}.hpp
      DEPENDS ${in} VERBATIM)
    add_custom_command(OUTPUT ${java_dir}/src/${ARG_PACKAGE}/${type}.java
      COMMAND ${LCM_GEN} --java --jpath ${java_dir}/src ${in} DEPENDS ${in} VERBATIM)
    list(APPEND headers ${cpp_dir}/${ARG_PACKAGE}/${type}.hpp)
    list(APPEND javas ${java_dir}/src/${ARG_PACKAGE}/${type}.java)
  endforeach()
  add_custom_target(${target}-gen DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}-gen)
  target_include_directories(${target} SYSTEM INTERFACE ${cpp_dir})
  target_link_libraries(${target} INTERFACE LCM::lcm)
  find_package(Java COMPONENTS Development QUIET)
  if(Java_JAVAC_EXECUTABLE AND LCM_JAR)
    add_custom_command(OUTPUT ${java_dir}/${target}.jar
      COMMAND ${CMAKE_COMMAND} -E make_directory ${java_dir}/classes
      COMMAND ${Java_JAVAC_EXECUTABLE} -nowarn -cp ${LCM_JAR} -d ${java_dir}/classes ${javas}
      COMMAND ${Java_JAR_EXECUTABLE} cf ${java_dir}/${target}.jar -C ${java_dir}/classes .
      DEPENDS ${javas} VERBATIM)
    add_custom_target(${target}-jar ALL DEPENDS ${java_dir}/${target}.jar)
  endif()
endfunction()
