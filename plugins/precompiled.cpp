// Carries the header that all plugins share precompiled; see CMakeLists.txt.
