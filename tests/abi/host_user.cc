/* SPDX-License-Identifier: BSD-3-Clause */
/* A user's host in C++17: opens and closes the simulated device, and says the version. */
#include <cstdio>
#include <dynpoint/driver.h>
#include <dynpoint/host.h>
int main()
{
    dpt_device *device = nullptr;
    if (dpt_device_open("sim", &device, nullptr) != DPT_OK)
        return 1;
    dpt_device_close(device);
    std::puts(dpt_version());
    return 0;
}
