/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Arms from small descriptions of our own, against numbers worked out by hand: docs/samples/arm.urdf, the convention of
 * rpy, mimics, what hangs beside the way to the tool, its capsules, the scene and where its meshes are found.
 */
#include "urdf/small_robot.h"

/* The tool's origin and the image of a point of its frame. */
static void check_tool(const struct robot *robot, const double *joints, const double point[3], const double want[3])
{
    dpt_pose pose;
    dpt_result result = dpt_arm_forward(robot->arm, joints, &pose);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    const double *q = pose.orientation;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        const double u[3] = { q[1], q[2], q[3] };
        double t[3];
        for (int m = 0; m < 3; m++)
            t[m] = 2.0 * (u[(m + 1) % 3] * point[(m + 2) % 3] - u[(m + 2) % 3] * point[(m + 1) % 3]);
        double is = pose.position[i] + point[i] + q[0] * t[i] + u[j] * t[k] - u[k] * t[j];
        CHECK(near(is, want[i]), "coordinate %d: %.17g, not %.17g", i, is, want[i]);
    }
}

static void check_link(const struct robot *robot, uint32_t index, uint32_t parent, uint32_t joint, double factor,
                       double offset, double mass)
{
    dpt_arm_link link = { .size = sizeof link };
    CHECK(dpt_arm_get_link(robot->arm, index, &link) == DPT_OK, "no link %u", index);
    CHECK(link.parent == parent && link.joint == joint, "link %u: on %u by %u", index, link.parent, link.joint);
    CHECK(near(link.factor, factor) && near(link.offset, offset), "link %u: %g q + %g", index, link.factor,
          link.offset);
    CHECK(near(link.mass, mass), "link %u: %g kg", index, link.mass);
}

/*
 * With axes -y, angles lift: the forearm's end is at radius r = 0.15 (cos s + cos (s + e)), height
 * 0.1 + 0.15 (sin s + sin (s + e)), turned by the waist about z.
 */
static void check_sample_at(const struct robot *robot, const double q[3])
{
    double cs = cos(q[1]), ss = sin(q[1]), ce = cos(q[1] + q[2]), se = sin(q[1] + q[2]), cw = cos(q[0]), sw = sin(q[0]);
    double r = 0.15 * (cs + ce), z = 0.1 + 0.15 * (ss + se);
    check_tool(robot, q, (double[3]){ 0.0, 0.0, 0.0 }, (double[3]){ r * cw, r * sw, z });
    /* The stylus's tip, 0.11 m below in its frame, that leans with the forearm. */
    double lean = r + 0.11 * se;
    check_tool(robot, q, (double[3]){ 0.0, 0.0, -0.11 }, (double[3]){ lean * cw, lean * sw, z - 0.11 * ce });
    double jacobian[18];
    CHECK(dpt_arm_jacobian(robot->arm, q, jacobian) == DPT_OK, "no Jacobian");
    const double want[18] = { -r * sw,
                              -(z - 0.1) * cw,
                              -0.15 * se * cw,
                              r * cw,
                              -(z - 0.1) * sw,
                              -0.15 * se * sw,
                              0.0,
                              r,
                              0.15 * ce,
                              0.0,
                              sw,
                              sw,
                              0.0,
                              -cw,
                              -cw,
                              1.0,
                              0.0,
                              0.0 };
    for (int k = 0; k < 18; k++)
        CHECK(near(jacobian[k], want[k]), "J[%d] %.17g, not %.17g", k, jacobian[k], want[k]);
    /* Weights act at 0.06 on the upper arm, 0.07 on the forearm and 0.15 with 0.04 below on the stylus. */
    double weight[3], g = 9.81, fore = 0.12 * (0.07 * ce) + 0.03 * (0.15 * ce + 0.04 * se),
                      upper = 0.25 * 0.06 * cs + 0.15 * 0.15 * cs;
    CHECK(dpt_arm_weight(robot->arm, q, (double[3]){ 0.0, 0.0, -g }, weight) == DPT_OK, "weight");
    CHECK(near(weight[0], 0.0) && near(weight[1], g * (upper + fore)) && near(weight[2], g * fore),
          "weight %g %g %g, not 0 %g %g", weight[0], weight[1], weight[2], g * (upper + fore), g * fore);
}

static void the_sample(void)
{
    struct robot robot = robot_of("docs/samples/arm.urdf", (dpt_urdf_def){ .size = 0 });
    CHECK(robot.notes[0] == 0, "%s", robot.notes);
    CHECK(robot.info.joints == 3 && robot.info.links == 3 && robot.info.segments == 1 && robot.info.bodies == 1 &&
              robot.info.tool_link == 2 && near(robot.info.mass, 0.8),
          "%u joints, %u links, %u segments, %u bodies, %g kg", robot.info.joints, robot.info.links,
          robot.info.segments, robot.info.bodies, robot.info.mass);
    CHECK(!strcmp(robot.info.name, "arm") && !strcmp(robot.info.root_name, "desk") &&
              !strcmp(robot.info.tool_name, "stylus"),
          "%s %s %s", robot.info.name, robot.info.root_name, robot.info.tool_name);
    dpt_arm_joint joint = { .size = sizeof joint };
    dpt_arm_get_joint(robot.arm, 2, &joint);
    CHECK(!strcmp(joint.name, "elbow") && joint.kind == DPT_JOINT_REVOLUTE && near(joint.lower, -2.2) &&
              near(joint.upper, 0.0) && near(joint.effort, 1.5) && near(joint.velocity, 20.0) &&
              near(joint.damping, 0.002) && near(joint.friction, 0.01),
          "%s: %g %g %g %g %g %g", joint.name, joint.lower, joint.upper, joint.effort, joint.velocity, joint.damping,
          joint.friction);
    uint64_t state = 1;
    for (int i = 0; i < 200; i++) {
        double q[3] = { random_in(&state, -1.2, 1.2), random_in(&state, -0.3, 1.4), random_in(&state, -2.2, 0.0) };
        check_sample_at(&robot, q);
    }
    dpt_segment s;
    CHECK(dpt_arm_get_segment(robot.arm, 0, &s) == DPT_OK, "no segment");
    CHECK(near(s.a[2], -0.106) && near(s.b[2], 0.006) && near(s.radius, 0.004) && near(s.a[0], 0.0),
          "from %g to %g, radius %g", s.a[2], s.b[2], s.radius);
    dpt_arm_body body = { .size = sizeof body };
    CHECK(dpt_arm_get_body(robot.arm, 0, &body) == DPT_OK && !strcmp(body.name, "desk"), "%s", body.name);
    const double above[6] = { 0.1, 0.2, 0.5, 0.1, 0.2, 0.3 };
    dpt_hit hit = DPT_HIT_INIT;
    CHECK(dpt_query_segments(body.mesh, &body.pose, above, NULL, 1, &hit, NULL) == DPT_OK &&
              fabs(hit.distance - 0.3) < 1e-6,
          "the desk's top is %g below", hit.distance);
    dpt_compiled_free(&robot.compiled);
}

#define LINKS(a, b, c) "<link name=\"" a "\"/><link name=\"" b "\"/><link name=\"" c "\"/>"

/* Fixed axes, x first: R = Rz(yaw) Ry(pitch) Rx(roll). */
static void roll_pitch_yaw(void)
{
    struct robot robot = robot_in(LINKS("base", "plate", "tip") JOINT("mount", "fixed", "base", "plate",
                                                                      "<origin xyz=\"1 2 3\" rpy=\"0.3 -0.4 0.5\"/>")
                                      JOINT("slide", "prismatic", "plate", "tip", "<axis xyz=\"0 0 1\"/>" LIMIT),
                                  NULL);
    double a = 0.3, b = -0.4, c = 0.5, q = 0.7;
    double z[3] = { cos(c) * sin(b) * cos(a) + sin(c) * sin(a), sin(c) * sin(b) * cos(a) - cos(c) * sin(a),
                    cos(b) * cos(a) };
    double x[3] = { cos(c) * cos(b), sin(c) * cos(b), -sin(b) };
    check_tool(&robot, &q, (double[3]){ 0.0, 0.0, 0.0 }, (double[3]){ 1.0 + q * z[0], 2.0 + q * z[1], 3.0 + q * z[2] });
    check_tool(&robot, &q, (double[3]){ 2.0, 0.0, 0.0 },
               (double[3]){ 1.0 + q * z[0] + 2.0 * x[0], 2.0 + q * z[1] + 2.0 * x[1], 3.0 + q * z[2] + 2.0 * x[2] });
    CHECK(robot.info.joints == 1 && robot.info.tool_link == 0, "%u joints", robot.info.joints);
    dpt_compiled_free(&robot.compiled);
}

/* Whatever stands for its characters in XML; and a file in Latin-1. */
static void names_come_through(void)
{
    const char *xml = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><robot name=\"bras \xe0 un axe\">"
                      "<link name=\"base\"/><link name='&lt;\"tip\"&gt;'/>"
                      "<joint name=\"100%s &amp; &#37;n &quot;&apos;&#233;\" type=\"continuous\">"
                      "<parent link=\"base\"/><child link=\"&lt;&quot;tip&quot;>\"/></joint></robot>";
    char path[128];
    snprintf(path, sizeof path, "%s/names.urdf", scratch);
    FILE *file = fopen(path, "w");
    fputs(xml, file);
    fclose(file);
    struct robot robot = robot_of(path, (dpt_urdf_def){ .tool = "<\"tip\">" });
    dpt_arm_joint joint = { .size = sizeof joint };
    dpt_arm_get_joint(robot.arm, 0, &joint);
    CHECK(!strcmp(robot.info.name, "bras \xc3\xa0 un axe"), "%s", robot.info.name);
    CHECK(!strcmp(robot.info.tool_name, "<\"tip\">"), "%s", robot.info.tool_name);
    CHECK(!strcmp(joint.name, "100%s & %n \"'\xc3\xa9"), "%s", joint.name);
    dpt_compiled_free(&robot.compiled);
}

/* c follows b follows a: c = -2 (3 a + 0.1) + 0.2 = -6 a. */
static void mimics_of_mimics(void)
{
    struct robot robot = robot_in(
        "<link name=\"tip\"/>" LINKS("base", "one", "two")
            JOINT("c", "prismatic", "two", "tip",
                  "<axis xyz=\"0 0 1\"/><mimic joint=\"b\" multiplier=\"-2\" offset=\"0.2\"/>" LIMIT)
                JOINT("b", "revolute", "one", "two",
                      "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/><mimic joint=\"a\" multiplier=\"3\" "
                      "offset=\"0.1\"/>" LIMIT) JOINT("a", "revolute", "base", "one", "<axis xyz=\"0 0 1\"/>" LIMIT),
        NULL);
    CHECK(robot.info.joints == 1 && robot.info.links == 3, "%u, %u", robot.info.joints, robot.info.links);
    check_link(&robot, 0, DPT_NONE, 0, 1.0, 0.0, 0.0);
    check_link(&robot, 1, 0, 0, 3.0, 0.1, 0.0);
    check_link(&robot, 2, 1, 0, -6.0, 0.0, 0.0);
    double q = 0.3, turn = q + 3.0 * q + 0.1;
    check_tool(&robot, &q, (double[3]){ 1.0, 0.0, 0.0 },
               (double[3]){ cos(q) + cos(turn), sin(q) + sin(turn), -6.0 * q });
    dpt_arm_joint joint = { .size = sizeof joint };
    dpt_arm_get_joint(robot.arm, 0, &joint);
    CHECK(!strcmp(joint.name, "a"), "%s", joint.name);
    dpt_compiled_free(&robot.compiled);
}

/*
 * A parallelogram as URDFs have it: the way to the tool mimics a joint beside it. What that one moves is weighed too;
 * what moves alone stands still, at 0 or at its nearest limit, and is fixed to what it stands on.
 */
static void beside_the_way(void)
{
    struct robot robot = robot_in(
        "<link name=\"base\">" MASS("0 0 0", "100") "</link><link name=\"crank\">" MASS(
            "1 0 0",
            "2") "</link><link name=\"boom\">" MASS("2 0 0",
                                                    "3") "</link><link name=\"tip\"/>"
                                                         "<link name=\"lamp\">" MASS("0 0 0", "1") "</link>" JOINT(
                                                             "drive", "revolute", "base", "crank",
                                                             "<axis xyz=\"0 -1 0\"/>" LIMIT)
                                                             JOINT("lift", "revolute", "base", "boom",
                                                                   "<axis xyz=\"0 -1 0\"/><mimic joint=\"drive\" "
                                                                   "multiplier=\"0.5\"/>" LIMIT)
                                                                 JOINT("end", "fixed", "boom", "tip",
                                                                       "<origin xyz=\"4 0 0\"/>")
                                                                     JOINT("swing", "prismatic", "boom", "lamp",
                                                                           "<axis xyz=\"1 0 0\"/><limit lower=\"0.5\" "
                                                                           "upper=\"1\" effort=\"1\" velocity=\"1\"/>"),
        "tip");
    CHECK(strstr(robot.notes, "joint 'swing' is no part of the arm: held at its limit nearest to 0") != NULL, "%s",
          robot.notes);
    CHECK(robot.info.joints == 1 && robot.info.links == 2 && near(robot.info.mass, 6.0), "%u joints, %u links, %g kg",
          robot.info.joints, robot.info.links, robot.info.mass);
    check_link(&robot, 0, DPT_NONE, 0, 1.0, 0.0, 2.0);
    check_link(&robot, 1, DPT_NONE, 0, 0.5, 0.0, 4.0);
    dpt_arm_link boom = { .size = sizeof boom };
    dpt_arm_get_link(robot.arm, 1, &boom);
    CHECK(near(boom.centre[0], (3.0 * 2.0 + 1.0 * 0.5) / 4.0), "centre at %g", boom.centre[0]);
    /* Lifting the drive by dq raises the crank's mass by cos(q) dq, the boom's by cos(q / 2) dq / 2. */
    double q = 0.8, weight, want = 2.0 * cos(q) + (3.0 * 2.0 + 0.5) * 0.5 * cos(0.5 * q);
    CHECK(dpt_arm_weight(robot.arm, &q, (double[3]){ 0.0, 0.0, -1.0 }, &weight) == DPT_OK && near(weight, want),
          "%.17g Nm, not %.17g", weight, want);
    check_tool(&robot, &q, (double[3]){ 0.0, 0.0, 0.0 }, (double[3]){ 4.0 * cos(0.5 * q), 0.0, 4.0 * sin(0.5 * q) });
    dpt_compiled_free(&robot.compiled);
}

/* The tool's capsules in its frame: shapes of the links that are fixed together, before and behind it. */
static void capsules(void)
{
    struct robot robot = robot_in(
        "<link name=\"base\"/><link name=\"wrist\"><collision><origin xyz=\"0 0 1\"/><geometry><sphere radius=\"0.5\"/>"
        "</geometry></collision></link>"
        "<link name=\"tool\"><collision><origin xyz=\"0 0.1 0\" rpy=\"0 1.5707963267948966 0\"/>"
        "<geometry><cylinder radius=\"0.1\" length=\"1\"/></geometry></collision>"
        "<collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>"
        "<link name=\"tip\"><collision><geometry><cylinder radius=\"0.3\" length=\"0.2\"/>"
        "</geometry></collision></link><link name=\"jaw\"><collision><geometry><sphere "
        "radius=\"0.5\"/></geometry></collision></link>" JOINT("j", "continuous", "base", "wrist", "")
            JOINT("h", "continuous", "tool", "jaw", "") JOINT("f", "fixed", "wrist", "tool", "<origin xyz=\"0 0 3\"/>")
                JOINT("t", "fixed", "tool", "tip", "<origin xyz=\"7 0 0\"/>"),
        "tool");
    const dpt_segment want[2] = { { { 0.0, 0.0, -2.0 }, { 0.0, 0.0, -2.0 }, 0.5 },
                                  { { -0.4, 0.1, 0.0 }, { 0.4, 0.1, 0.0 }, 0.1 } };
    CHECK(robot.info.segments == 2, "%u segments", robot.info.segments);
    for (uint32_t i = 0; i < robot.info.segments; i++) {
        dpt_segment s;
        dpt_arm_get_segment(robot.arm, i, &s);
        for (int k = 0; k < 3; k++)
            CHECK(near(s.a[k], want[i].a[k]) && near(s.b[k], want[i].b[k]), "segment %u: %g %g", i, s.a[k], s.b[k]);
        CHECK(near(s.radius, want[i].radius), "segment %u: radius %g", i, s.radius);
    }
    CHECK(robot.info.tips == 3 && robot.info.jaws == 1 && robot.info.jaw_links == 1, "%u tips, %u jaws",
          robot.info.tips, robot.info.jaws);
    CHECK(!strstr(robot.notes, "left out") && !strstr(robot.notes, "no part of") &&
              strstr(robot.notes, "link 'tip': a cylinder is felt with 16 flat sides"),
          "%s", robot.notes);
    dpt_compiled_free(&robot.compiled);
}

/* Its length is without the round ends. An urdfdom before 5.1 knows neither it nor the quaternion: a refusal. */
static void a_capsule_of_urdf_1_1(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/capsule.urdf", scratch);
    FILE *file = fopen(path, "w");
    fputs("<robot name=\"r\" version=\"1.1\"><link name=\"base\"/><link name=\"tip\"><collision>"
          "<origin xyz=\"0 0 1\" quat_xyzw=\"1 0 0 0\"/><geometry><capsule radius=\"0.1\" length=\"0.4\"/>"
          "</geometry></collision></link>" JOINT("j", "continuous", "base", "tip", "") "</robot>\n",
          file);
    fclose(file);
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled;
    dpt_result result = dpt_urdf_compile_file(path, NULL, &compiled, &diag);
    if (result != DPT_OK) {
        CHECK(diag.line == 1 &&
                  (strstr(diag.text, "knows no <capsule>") || strstr(diag.text, "has no attribute 'quat_xyzw'")),
              "%s", diag.text);
        return;
    }
    const dpt_arm *arm;
    dpt_segment s = { { 0.0 }, { 0.0 }, 0.0 };
    CHECK(dpt_arm_open(compiled.bytes, compiled.size, &arm) == DPT_OK && dpt_arm_get_segment(arm, 0, &s) == DPT_OK,
          "no capsule");
    CHECK(near(s.radius, 0.1) && near(s.a[2], 1.2) && near(s.b[2], 0.8), "%g to %g, %g", s.a[2], s.b[2], s.radius);
    dpt_compiled_free(&compiled);
}

/* Of a mesh that is called `name`; whether the reason ends in `ending`. */
static int mesh_is_refused(const char *link, const char *name, const char *ending, dpt_diag *diag)
{
    char path[128];
    dpt_compiled compiled;
    snprintf(path, sizeof path, "%s/robots/plate.urdf", scratch);
    FILE *file = fopen(path, "w");
    fprintf(file,
            "<robot name=\"r\"><link name=\"%s\"><collision><geometry><mesh filename=\"%s\"/>"
            "</geometry></collision></link><link name=\"tip\"/><joint name=\"j\" "
            "type=\"continuous\"><parent link=\"%s\"/><child link=\"tip\"/></joint></robot>\n",
            link, name, link);
    fclose(file);
    *diag = (dpt_diag){ .size = sizeof *diag };
    dpt_result result = dpt_urdf_compile_file(path, NULL, &compiled, diag);
    size_t length = strlen(diag->text), end = strlen(ending);
    return result != DPT_OK && length >= end && !strcmp(diag->text + length - end, ending);
}

/* No character of UTF-8 is cut. */
static int is_whole(const char *text)
{
    int more = 0;
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if ((c & 0xc0) == 0x80 ? more-- == 0 : more != 0)
            return 0;
        if (c >= 0xc0)
            more = c >= 0xe0 ? 2 : 1;
    }
    return more == 0;
}

/* The whole path, or both of its ends: neither the reason is cut nor the file's own name. */
static void a_long_path_is_told(void)
{
    static const char *const reasons[][2] = {
        { "plate.obj", ": it cannot be opened: No such file or directory" },
        { "plate.dae", " is COLLADA: make it an STL (docs/urdf.md#collada-and-gltf), or leave it out: --skip LINK" },
        { "plate.obj%", ": '%' is not followed by two digits of a character" },
    };
    static const char *const links[] = { "base", "a_link_whose_name_is_longer_than_forty_bytes" };
    static const char *const folders[] = { "a_folder_of_many/words/for/all/organs/meshes/",
                                           "b\xe2\x82\xac\xe2\x82\xac\xc3\xa4/" };
    char name[1024], wanted[1200];
    dpt_diag diag;
    for (int i = 0; i < 3 * 2 * 2 * 20; i++) {
        const char *const *reason = reasons[i % 3];
        strcpy(name, i % 3 == 2 ? "package://p/" : "");
        for (int k = 0; k < i / 12; k++)
            strcat(name, folders[i / 6 % 2]);
        strcat(name, reason[0]);
        snprintf(wanted, sizeof wanted, "%s'%s", reason[0], reason[1]);
        CHECK(mesh_is_refused(links[i / 3 % 2], name, wanted, &diag) && is_whole(diag.text), "%s: %s", name, diag.text);
        CHECK(i / 3 % 2 || !strstr(diag.text, "...") || strlen(diag.text) > 150, "%s", diag.text);
    }
    snprintf(name, sizeof name, "%s%s", folders[0], "meshes/of/patients/plate.obj");
    snprintf(wanted, sizeof wanted, "link 'base': '%s'%s", name, reasons[0][1]);
    CHECK(mesh_is_refused("base", name, wanted, &diag), "%s", diag.text);
}

/* A plate of the scene, by its file's name; its edge in metres, 0 when the compiler refuses. */
static double plate(const char *name, const char *more, const char *packages, double scale)
{
    char path[128];
    snprintf(path, sizeof path, "%s/robots/plate.urdf", scratch);
    FILE *file = fopen(path, "w");
    fprintf(file,
            "<robot name=\"r\"><link name=\"base\"><collision><origin xyz=\"0 0 5\"/><geometry><mesh "
            "filename=\"%s\" %s/></geometry></collision></link><link name=\"tip\"/>" JOINT("j", "continuous", "base",
                                                                                           "tip", "") "</robot>\n",
            name, more);
    fclose(file);
    dpt_compile_def mesh = { .size = sizeof mesh, .scale = scale };
    dpt_urdf_def def = { .size = sizeof def, .packages = packages, .mesh = &mesh };
    dpt_compiled compiled;
    double edge = 0.0;
    if (dpt_urdf_compile_file(path, &def, &compiled, NULL) == DPT_OK) {
        const dpt_arm *arm;
        dpt_arm_body body = { .size = sizeof body };
        dpt_mesh_info info = { .size = sizeof info };
        CHECK(dpt_arm_open(compiled.bytes, compiled.size, &arm) == DPT_OK &&
                  dpt_arm_get_body(arm, 0, &body) == DPT_OK && dpt_mesh_get_info(body.mesh, &info) == DPT_OK &&
                  near(body.pose.position[2], 5.0),
              "%s: no body", name);
        edge = info.box_max[0] - info.box_min[0];
    }
    dpt_compiled_free(&compiled);
    return edge;
}

static void where_meshes_are(void)
{
    char here[1024], address[1200], command[256];
    snprintf(command, sizeof command,
             "mkdir %s/robots && cp -r tests/golden-urdf/meshes tests/golden-urdf/packages %s/robots", scratch,
             scratch);
    CHECK(system(command) == 0, "%s", command);
    CHECK(getcwd(here, sizeof here) != NULL, "no folder");
    const struct {
        const char *name, *more, *packages;
        double scale, edge;
    } cases[] = {
        { "meshes/plate.obj", "", NULL, 0.0, 1.0 },
        { "./meshes/../meshes/plate.obj", "scale=\"0.5 0.5 0.5\"", NULL, 0.0, 0.5 },
        { "meshes/plate.obj", "scale=\"0.5 0.5 0.5\"", NULL, 0.5, 0.25 },
        /* The folders given, one after the other; then those above: robots, the scratch folder's, ..., the tree. */
        { "package://plates/meshes/large%20plate.obj", "", "/nonesuch::tests/golden-urdf/packages", 0.0, 2.0 },
        { "package://plates/meshes/large plate.obj", "", "tests/golden-urdf/packages", 0.0, 2.0 },
        /* A folder may be the package itself. */
        { "package://plates/meshes/large plate.obj", "", "tests/golden-urdf/packages/plates/", 0.0, 2.0 },
        { "package://late/meshes/large plate.obj", "", "tests/golden-urdf/packages/plates", 0.0, 0.0 },
        { "package://meshes/plate.obj", "", NULL, 0.0, 1.0 },
        { "package://robots/meshes/plate.obj", "", "/nonesuch", 0.0, 1.0 },
        { "package://tests/golden-urdf/meshes/plate.obj", "", NULL, 0.0, 1.0 },
        /* Last, behind NAME in the file's own. */
        { "package://elsewhere/meshes/plate.obj", "", NULL, 0.0, 1.0 },
        { "package://elsewhere/packages/plates/meshes/large%20plate.obj", "", NULL, 0.0, 2.0 },
        { "package://plates/meshes/large%20plate.obj", "", NULL, 0.0, 0.0 },
        { "packages/plates/meshes/large%20plate.obj", "", NULL, 0.0, 0.0 },
        { "packages/plates/meshes/large plate.obj", "", NULL, 0.0, 2.0 },
        { "http://meshes/plate.obj", "", NULL, 0.0, 0.0 },
        { "file://meshes/plate.obj", "", NULL, 0.0, 0.0 },
        { "/robots/meshes/plate.obj", "", NULL, 0.0, 0.0 },
        { "../meshes/plate.obj", "", NULL, 0.0, 0.0 },
        { "../robots/meshes/plate.obj", "", NULL, 0.0, 1.0 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double edge = plate(cases[i].name, cases[i].more, cases[i].packages, cases[i].scale);
        CHECK(near(edge, cases[i].edge), "%s: %g m, not %g", cases[i].name, edge, cases[i].edge);
    }
    if (strpbrk(here, " %#")) {
        SKIP("file:// of this folder", "its name would have to be encoded");
        return;
    }
    snprintf(address, sizeof address, "file://%s/tests/golden-urdf/meshes/plat%%65.obj", here);
    CHECK(near(plate(address, "", NULL, 0.0), 1.0), "%s", address);
    snprintf(address, sizeof address, "file://localhost%s/tests/golden-urdf/meshes/plate.obj", here);
    CHECK(near(plate(address, "", NULL, 0.0), 1.0), "%s", address);
    snprintf(address, sizeof address, "%s/tests/golden-urdf/meshes/plate.obj", here);
    CHECK(near(plate(address, "", NULL, 0.0), 1.0), "%s", address);
}

/* A robot whose scene cannot be read: a mesh of COLLADA on its base, and a box on what is fixed to that. */
static const char blocked[] =
    "<link name=\"base\"><collision><geometry><mesh filename=\"base.dae\"/></geometry></collision></link>"
    "<link name=\"shelf\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>"
    "<link name=\"tip\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>" JOINT(
        "f", "fixed", "base", "shelf", "") JOINT("j", "continuous", "base", "tip", "");

static void links_and_the_scene_can_be_left_out(void)
{
    const char *const base[] = { "base", NULL }, *const all[] = { "tip", "base", "shelf", NULL };
    const struct {
        dpt_urdf_def def;
        uint32_t bodies, capsules;
    } cases[] = { { { .tool = "tip", .skip = base }, 1, 1 },
                  { { .tool = "tip", .without_scene = 1 }, 0, 1 },
                  { { .tool = "tip", .skip = all }, 0, 0 } };
    char path[128];
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    snprintf(path, sizeof path, "%s/blocked.urdf", scratch);
    FILE *file = fopen(path, "w");
    fprintf(file, "<robot name=\"r\">%s</robot>\n", blocked);
    fclose(file);
    const dpt_urdf_def plain = { .size = sizeof plain, .tool = "tip" };
    CHECK(dpt_urdf_compile_file(path, &plain, &compiled, &diag) == DPT_E_UNSUPPORTED &&
              strstr(diag.text, "'base.dae' is COLLADA") && strstr(diag.text, "--skip"),
          "%s", diag.text);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct robot robot = robot_of(path, cases[i].def);
        CHECK(robot.info.bodies == cases[i].bodies && robot.info.segments == cases[i].capsules,
              "case %zu: %u bodies, %u capsules", i, robot.info.bodies, robot.info.segments);
        dpt_compiled_free(&robot.compiled);
    }
}

/* Many links of long names without children: the message is whole, and says what to do. */
static void a_long_list_of_tools_fits(void)
{
    char path[128];
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    for (int links = 2; links < 12; links++) {
        snprintf(path, sizeof path, "%s/ends_%d.urdf", scratch, links);
        FILE *file = fopen(path, "w");
        fprintf(file, "<robot name=\"r\"><link name=\"base\"/>");
        for (int i = 0; i < links; i++)
            fprintf(file,
                    "<link name=\"the_finger_of_a_hand_with_a_long_name_%d\"/><joint name=\"j%d\" type=\"fixed\">"
                    "<parent link=\"base\"/><child link=\"the_finger_of_a_hand_with_a_long_name_%d\"/></joint>",
                    i, i, i);
        fprintf(file, "</robot>\n");
        fclose(file);
        CHECK(dpt_urdf_compile_file(path, NULL, &compiled, &diag) == DPT_E_ARGUMENT, "%d links", links);
        const size_t length = strlen(diag.text);
        CHECK(strstr(diag.text, "name the link that is the tool by --tool") &&
                  (diag.text[length - 1] == '\'' || strcmp(diag.text + length - 5, ", ...") == 0),
              "%s", diag.text);
    }
}

/* A mesh far from its link's origin is moved, and its body makes up for it. */
static void a_mesh_that_is_moved_stays_in_its_place(void)
{
    char path[128];
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compile_def mesh = { .size = sizeof mesh };
    dpt_urdf_def def = { .size = sizeof def, .mesh = &mesh };
    dpt_arm_body body = { .size = sizeof body };
    const float *xyz;
    uint32_t count;
    snprintf(path, sizeof path, "%s/far.obj", scratch);
    FILE *file = fopen(path, "w");
    fprintf(file, "v 500000 1 2\nv 500000.01 1 2\nv 500000 1.02 2\nf 1 2 3\n");
    fclose(file);
    snprintf(path, sizeof path, "%s/far.urdf", scratch);
    file = fopen(path, "w");
    fprintf(
        file,
        "<robot name=\"r\"><link name=\"base\"><collision><origin xyz=\"7 0 0\" rpy=\"0 0 1.57079632679489661923\"/>"
        "<geometry><mesh filename=\"far.obj\"/></geometry></collision></link><link name=\"tip\"/>" JOINT(
            "j", "continuous", "base", "tip", "") "</robot>\n");
    fclose(file);
    CHECK(dpt_urdf_compile_file(path, &def, &compiled, &diag) == DPT_E_FINITE && strstr(diag.text, "--recentre"), "%s",
          diag.text);
    mesh.recentre = 1;
    struct robot robot = robot_of(path, (dpt_urdf_def){ .mesh = &mesh });
    CHECK(dpt_arm_get_body(robot.arm, 0, &body) == DPT_OK && dpt_mesh_get_vertices(body.mesh, &xyz, &count) == DPT_OK &&
              count == 3,
          "no body");
    /* The turn by a quarter takes x to y. */
    CHECK(fabs(body.pose.position[1] + (double)xyz[0] - 500000.0) < 1e-9 &&
              fabs(body.pose.position[0] - (double)xyz[1] - (7.0 - 1.0)) < 1e-9,
          "%.12g %.12g", body.pose.position[0], body.pose.position[1]);
    dpt_compiled_free(&robot.compiled);
}

/* Bodies are all meshes and boxes of what is fixed to the root; not of a door in it, though it stands still here. */
static void the_scene(void)
{
    struct robot robot =
        robot_in("<link name=\"base\"><collision><geometry><sphere radius=\"1\"/></geometry></collision></link>"
                 "<link name=\"table\"><collision><origin xyz=\"0 0 -1\"/><geometry><box size=\"2 2 2\"/>"
                 "</geometry></collision><collision><origin xyz=\"3 0 0\"/><geometry><box size=\"1 1 1\"/>"
                 "</geometry></collision></link><link name=\"door\"><collision><geometry><box size=\"1 1 "
                 "1\"/></geometry></collision></link><link name=\"tip\"/>" JOINT(
                     "foot", "fixed", "base", "table", "<origin xyz=\"0 0 10\" rpy=\"0 0 1.5707963267948966\"/>")
                     JOINT("hinge", "revolute", "base", "door",
                           "<axis xyz=\"0 0 1\"/><limit lower=\"1.5707963267948966\" upper=\"2\" effort=\"1\" "
                           "velocity=\"1\"/>") JOINT("j", "continuous", "table", "tip", ""),
                 "tip");
    const double at[2][3] = { { 0.0, 0.0, 9.0 }, { 0.0, 3.0, 10.0 } };
    CHECK(robot.info.bodies == 2, "%u bodies", robot.info.bodies);
    for (uint32_t i = 0; i < robot.info.bodies; i++) {
        dpt_arm_body body = { .size = sizeof body };
        dpt_arm_get_body(robot.arm, i, &body);
        CHECK(!strcmp(body.name, "table"), "%u: %s", i, body.name);
        for (int k = 0; k < 3; k++)
            CHECK(near(body.pose.position[k], at[i][k]), "%u: %g", i, body.pose.position[k]);
        CHECK(near(body.pose.orientation[3], sqrt(0.5)), "%u: %g", i, body.pose.orientation[3]);
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(body.mesh, &info);
        CHECK(info.closed_components == 1 && info.solid_components == 1 && !info.inward_components &&
                  !info.turned_triangles,
              "%u: a box that is not closed or wound inward", i);
    }
    CHECK(strstr(robot.notes, "link 'base': 1 collision shape left out") &&
              strstr(robot.notes, "link 'door': 1 collision shape left out") &&
              strstr(robot.notes, "joint 'hinge' is no part of the arm: held at its limit nearest"),
          "%s", robot.notes);
    dpt_compiled_free(&robot.compiled);
}

int main(void)
{
    if (!scratch_make("urdf_arm"))
        return 1;
    TEST(the_sample);
    TEST(roll_pitch_yaw);
    TEST(names_come_through);
    TEST(mimics_of_mimics);
    TEST(beside_the_way);
    TEST(capsules);
    TEST(a_capsule_of_urdf_1_1);
    TEST(where_meshes_are);
    TEST(links_and_the_scene_can_be_left_out);
    TEST(a_long_list_of_tools_fits);
    TEST(a_mesh_that_is_moved_stays_in_its_place);
    TEST(a_long_path_is_told);
    TEST(the_scene);
    scratch_remove();
    return check_report();
}
