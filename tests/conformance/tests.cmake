#Every plugin of the build tree is checked, so all of them must be there.
get_property(all_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
    add_dependencies(test_conformance ${all_plugins})
