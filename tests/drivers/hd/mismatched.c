/* SPDX-License-Identifier: BSD-3-Clause */
/* A library beside a device driver of another version: it needs what that one does not have. */
void phantom_driver_of_another_version(void);
__attribute__((visibility("default"))) void hdStartScheduler(void);

void hdStartScheduler(void)
{
    phantom_driver_of_another_version();
}
