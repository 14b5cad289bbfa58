#include "world/proxy_rig.h"
#define TOP 0.04
int main(void)
{
    const dpt_segment lying = { { -0.01, 0, 0 }, { 0.01, 0, 0 }, 0.002 };
    struct solid box; struct rig rig; uint64_t seed = 4; double tremor[3] = { 0, 0, 0 };
    if (!solid_from_shape(&box, "box", 300)) return 1;
    rig_open(&rig, NULL, box.mesh, &lying, 1);
    rig_set_friction(&rig, 0.5, 0.4);
    rig.device.position[2] = TOP + lying.radius + 0.001;
    rig_place(&rig);
    for (int i = 0; i < 40; i++) { rig.device.position[2] -= 1e-4; rig_step(&rig); }
    for (int i = 0; i < 27; i++) { rig.device.position[0] += 5e-5; rig_step(&rig); }
    const dpt_pose device = rig.device, at = rig.proxy;
    for (int i = 0; i < 100000; i++) {
        for (int k = 0; k < 3; k++) {
            tremor[k] = 0.9 * tremor[k] + random_in(&seed, -1e-6, 1e-6);
            rig.device.position[k] = device.position[k] + fmax(-3e-5, fmin(3e-5, 5 * tremor[k]));
        }
        rig_step(&rig);
        static int seen; if (rig.force.slipping) seen++; if (rig.force.slipping && seen < 4) printf("%d x %g y %g q %g %g %g F %g %g %g T %g slip %u stick %u\n", i, rig.proxy.position[0]-at.position[0], rig.proxy.position[1]-at.position[1], rig.proxy.orientation[1], rig.proxy.orientation[2], rig.proxy.orientation[3], rig.force.wrench.force[0],rig.force.wrench.force[1],rig.force.wrench.force[2],rig.force.wrench.torque[0], rig.force.slipping, rig.force.sticking);
    }
    return 0;
}
