/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The paper's z-buffer (Maciel and De 2008): which triangle a moving segment crosses first, told by a picture that is
 * drawn along it. A program of its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_zbuffer MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--pixel SHARE] [--motion NAME:STEP] [--json]
 *
 * The files' formats are in peer.h. The camera stands at end a and looks at end b; the near and the far plane are the
 * ends. Each triangle is drawn in a colour of its own, its number, and the pixel on the axis is read back. A picture
 * tells no distance: that column is 0 where a triangle is seen, else empty. It is drawn by what Mesa draws with in
 * software, unless GALLIUM_DRIVER or LIBGL_ALWAYS_SOFTWARE says otherwise; --json has the renderer's own name.
 *
 * How it is asked, so that the comparison is fair:
 * - The picture is the one pixel that is read, off the screen.
 * - The view is parallel: the near plane of a perspective would hide the tool's first part.
 * - The pixel is a hundred-thousandth of the tool's length wide. The renderer snaps corners to 1/256 of a pixel, so
 *   errors grow with it; time hardly does. --pixel 2e-3 is that of a picture of 512 pixels across the tool's length.
 * - Corners are moved to end a before they are turned, so that float loses little of a large coordinate.
 * - Depth is 32-bit float. Both sides of a triangle are drawn, each vertex is transformed about once, and number and
 *   depth come back in one read. Nothing is shaded.
 * - One thread, as all peers (LP_NUM_THREADS sets them): one pixel leaves nothing to share out.
 *
 * With --motion all vertices are handed to the renderer again each tick.
 */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl32.h>

#include "peer_motion.h"

namespace
{

using namespace peer;

const double PIXEL = 1e-5;

const char *const VERTEX =
    "#version 320 es\n"
    "in vec3 corner;\n"
    "uniform vec3 eye;\n"
    "uniform mat3 view;\n"
    "void main() { gl_Position = vec4(view * (corner - eye) - vec3(0, 0, 1), 1); }\n";

const char *const FRAGMENT =
    "#version 320 es\n"
    "precision highp float;\n"
    "precision highp int;\n"
    "out uvec4 seen;\n"
    "void main() { seen = uvec4(gl_PrimitiveID + 1, floatBitsToUint(gl_FragCoord.z), 0, 0); }\n";

/* A context of EGL that draws on no screen. */
class Screenless
{
  public:
    Screenless()
    {
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
        setenv("GALLIUM_DRIVER", "llvmpipe", 0);
        setenv("LP_NUM_THREADS", "0", 0);
        const EGLint want[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2,
                                EGL_NONE };
        const EGLint config_want[] = { EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT,
                                       EGL_NONE };
        EGLConfig config;
        EGLint configs = 0;

        display_ =
            eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr) ||
            !eglBindAPI(EGL_OPENGL_ES_API) ||
            !eglChooseConfig(display_, config_want, &config, 1, &configs) || configs < 1)
            fail("EGL has no display without a screen");
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, want);
        if (context_ == EGL_NO_CONTEXT ||
            !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            fail("EGL has no context of OpenGL ES 3.2");
    }

    ~Screenless()
    {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

  private:
    Screenless(const Screenless &) = delete;

    EGLDisplay display_;
    EGLContext context_;
};

class Peer
{
  public:
    Peer(const Mesh &mesh, double pixel)
        : pixel_(pixel), corners_(3 * (GLsizei)mesh.triangles.size())
    {
        std::vector<float> positions;
        for (const Point &p : mesh.vertices)
            for (double x : p)
                positions.push_back((float)x);
        glGenBuffers(2, buffers_);
        glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
        glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(positions.size() * sizeof(float)),
                     positions.data(), GL_STREAM_DRAW);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[1]);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                     (GLsizeiptr)(mesh.triangles.size() * sizeof mesh.triangles[0]),
                     mesh.triangles.data(), GL_STATIC_DRAW);
        make_picture();
        make_program();
        if (glGetError() != GL_NO_ERROR)
            fail("OpenGL ES cannot hold the mesh");
    }

    static std::string renderer()
    {
        return (const char *)glGetString(GL_RENDERER);
    }

    void move(const struct vertex_motion &motion)
    {
        glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(3 * sizeof(float) * motion.vertices),
                     motion.positions, GL_STREAM_DRAW);
    }

    void reset()
    {
    }

    void count(bool)
    {
    }

    Answer ask(const Tick &tick, bool)
    {
        const GLuint nothing[4] = { 0, 0, 0, 0 };
        GLuint seen[4] = { 0, 0, 0, 0 };

        set_view(tick);
        glClear(GL_DEPTH_BUFFER_BIT);
        glClearBufferuiv(GL_COLOR, 0, nothing);
        glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
        glReadPixels(0, 0, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, seen);
        if (!seen[0])
            return Answer{ std::numeric_limits<double>::quiet_NaN(), -1 };
        return Answer{ 0, (long)seen[0] - 1 };
    }

    double bv_tests() const
    {
        return std::numeric_limits<double>::quiet_NaN();
    }

    double leaf_tests() const
    {
        return std::numeric_limits<double>::quiet_NaN();
    }

  private:
    Peer(const Peer &) = delete;

    void make_picture()
    {
        GLuint frame, layers[2];

        glGenFramebuffers(1, &frame);
        glGenRenderbuffers(2, layers);
        glBindFramebuffer(GL_FRAMEBUFFER, frame);
        glBindRenderbuffer(GL_RENDERBUFFER, layers[0]);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_RG32UI, 1, 1);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, layers[0]);
        glBindRenderbuffer(GL_RENDERBUFFER, layers[1]);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, 1, 1);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, layers[1]);
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            fail("OpenGL ES has no picture of numbers");
        glViewport(0, 0, 1, 1);
        glEnable(GL_DEPTH_TEST);
        glDisable(GL_CULL_FACE);
        glDisable(GL_DITHER);
    }

    static GLuint shader(GLenum kind, const char *source)
    {
        GLuint made = glCreateShader(kind);
        GLint good = 0;

        glShaderSource(made, 1, &source, nullptr);
        glCompileShader(made);
        glGetShaderiv(made, GL_COMPILE_STATUS, &good);
        if (!good)
            fail("OpenGL ES does not take a shader");
        return made;
    }

    void make_program()
    {
        GLuint program = glCreateProgram();
        GLint good = 0;

        glAttachShader(program, shader(GL_VERTEX_SHADER, VERTEX));
        glAttachShader(program, shader(GL_FRAGMENT_SHADER, FRAGMENT));
        glBindAttribLocation(program, 0, "corner");
        glLinkProgram(program);
        glGetProgramiv(program, GL_LINK_STATUS, &good);
        if (!good)
            fail("OpenGL ES does not link its program");
        glUseProgram(program);
        glEnableVertexAttribArray(0);
        glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
        eye_ = glGetUniformLocation(program, "eye");
        view_ = glGetUniformLocation(program, "view");
    }

    /* End a to depth -1, end b to depth 1; across the axis a pixel to 2. */
    void set_view(const Tick &tick)
    {
        Vec a = vec(tick.a), u = vec(tick.b) - a;
        double length = std::sqrt(dot(u, u)), scale = length > 0 ? 1 / length : 0;
        Vec z = scale * u;
        Vec x = cross(z, std::fabs(z.x) < 0.6 ? Vec{ 1, 0, 0 } : Vec{ 0, 1, 0 });
        x = (1 / std::sqrt(dot(x, x))) * x;
        Vec y = cross(z, x);
        double wide = 2 * scale / pixel_, deep = 2 * scale;
        const float eye[3] = { (float)a.x, (float)a.y, (float)a.z };
        const float view[9] = { (float)(wide * x.x), (float)(wide * y.x), (float)(deep * z.x),
                                (float)(wide * x.y), (float)(wide * y.y), (float)(deep * z.y),
                                (float)(wide * x.z), (float)(wide * y.z), (float)(deep * z.z) };

        glUniform3fv(eye_, 1, eye);
        glUniformMatrix3fv(view_, 1, GL_FALSE, view);
    }

    double pixel_;
    GLsizei corners_;
    GLuint buffers_[2];
    GLint eye_ = -1, view_ = -1;
};

Measured ask_renderer(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                      std::string &name)
{
    double pixel = options.choice.empty() ? PIXEL : std::atof(options.choice.c_str());

    if (!(pixel >= 1e-9 && pixel <= 1))
        fail("--pixel takes a number from 1e-9 to 1");
    Screenless screenless;
    double begin = now_ns();
    Peer peer(mesh, pixel);
    double build_ns = now_ns() - begin;
    name = "z-buffer on " + Peer::renderer();
    Measured measured = measure_any(peer, mesh, trace, options);
    measured.build_ns = build_ns;
    return measured;
}

} // namespace

int main(int argc, char **argv)
{
    About about = { "peer_zbuffer",
                    "EGL",
                    "1.5, OpenGL ES 3.2",
                    "The triangle that the segment of each tick crosses first",
                    "--pixel",
                    "SHARE",
                    "of the tool's length that the pixel is wide (1e-5)",
                    true };

    return peer_main(argc, argv, about, ask_renderer);
}
