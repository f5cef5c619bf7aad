# find_package(Veridyn [COMPONENTS module ...]) for those who install the library.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Veridyn)
install(EXPORT VeridynTargets NAMESPACE Veridyn:: DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/VeridynConfig.cmake.in ${PROJECT_BINARY_DIR}/VeridynConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/VeridynConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/VeridynConfig.cmake ${PROJECT_BINARY_DIR}/VeridynConfigVersion.cmake DESTINATION ${package_dir})
