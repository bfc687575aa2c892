# SPDX-License-Identifier: Apache-2.0
# Some tests state problems with real plugins.
add_dependencies(test_problem lapwing_vehicle_model_quadrotor lapwing_cost_term_derivative)
