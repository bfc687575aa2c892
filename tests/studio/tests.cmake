# SPDX-License-Identifier: Apache-2.0
# The program is run, with a plugin that crashes.
add_dependencies(test_studio lapwing_app lapwing_fixture_rogue)
get_property(studio_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
add_dependencies(test_studio ${studio_plugins})
