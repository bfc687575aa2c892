# SPDX-License-Identifier: Apache-2.0
# Some tests state problems with real plugins.
add_dependencies(test_problem lapwing_vehicle_model_quadrotor lapwing_cost_term_derivative
                 lapwing_cost_term_keyframe lapwing_constraint_input_limits
                 lapwing_constraint_state_limits lapwing_trajectory_solver_iqp)
