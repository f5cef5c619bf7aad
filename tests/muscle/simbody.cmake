# Simbody, the multibody library under OpenSim, as the judge and the rival of ours, for tests and benchmarks: target
# veridyn_simbody_tree, where Simbody is found. Its headers are C++17.
find_package(Simbody QUIET)
if(Simbody_FOUND AND NOT TARGET veridyn_simbody_tree)
  add_library(veridyn_simbody_tree STATIC ${CMAKE_CURRENT_LIST_DIR}/simbody_tree.cpp)
  set_target_properties(veridyn_simbody_tree PROPERTIES CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON)
  # Classes in its headers have members that NDEBUG takes away; Debian's library was built with them.
  target_compile_options(veridyn_simbody_tree PRIVATE -UNDEBUG)
  target_include_directories(veridyn_simbody_tree PUBLIC ${PROJECT_SOURCE_DIR})
  target_include_directories(veridyn_simbody_tree SYSTEM PRIVATE ${Simbody_INCLUDE_DIR})
  target_link_libraries(veridyn_simbody_tree PUBLIC Eigen3::Eigen PRIVATE SimTKsimbody)
endif()
