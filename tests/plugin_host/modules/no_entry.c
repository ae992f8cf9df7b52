/* A library that is no plugin at all. */
int rt_test_something(void) { return 1; }
