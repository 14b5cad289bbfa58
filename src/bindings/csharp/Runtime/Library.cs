// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.IO;
using System.Runtime.InteropServices;
using System.Text;

namespace Dynpoint
{
    /// <summary>What the library refused: its text, and its code.</summary>
    public sealed class DynpointException : Exception
    {
        internal DynpointException(string what, Result result, string text) : base(what + ": " + text)
        {
            Result = result;
        }

        /// <summary>The code, as Result.EHandle.</summary>
        public Result Result { get; private set; }

        internal static void Check(Result result, string what)
        {
            if (result != Result.Ok) throw Make(result, what, null);
        }

        internal static unsafe DynpointException Make(Result result, string what, string text)
        {
            string name = Utf8.Read(Native.dpt_result_name(result), 100);
            if (string.IsNullOrEmpty(text)) text = Utf8.Read(Native.dpt_result_text(result), 1000);
            return new DynpointException(what, result, text + " (" + name + ")");
        }
    }

    /// <summary>Texts as the library has them.</summary>
    public static unsafe class Utf8
    {
        internal static string Read(byte* text, int capacity)
        {
            if (text == null) return null;
            int count = 0;
            while (count < capacity && text[count] != 0) count++;
            byte[] bytes = new byte[count];
            for (int i = 0; i < count; i++) bytes[i] = text[i];
            return Encoding.UTF8.GetString(bytes);
        }

        /// <summary>Bytes that end in zero; null for null.</summary>
        internal static byte[] Bytes(string text)
        {
            if (text == null) return null;
            if (text.IndexOf('\0') >= 0) throw new ArgumentException("a text for the library has a zero in it");
            return Encoding.UTF8.GetBytes(text + "\0");
        }
    }

    /// <summary>Whether the native library is there, and is new enough.</summary>
    public static class Library
    {
        private static volatile bool isThere;

        /// <summary>The version of the native library, as "0.3.0".</summary>
        public static unsafe string Version
        {
            get
            {
                Load();
                return Utf8.Read(Native.dpt_version(), 100);
            }
        }

        /// <summary>Loads the native library. All that is made of it calls this.</summary>
        /// <exception cref="DllNotFoundException">It is not there. The text says where it was looked for.</exception>
        public static void Load()
        {
            if (isThere) return;
            uint number;
            try
            {
                number = Native.dpt_version_number();
            }
            catch (DllNotFoundException error)
            {
                throw new DllNotFoundException(Where(), error);
            }
            catch (BadImageFormatException error) // .NET, of one for another processor
            {
                throw new DllNotFoundException(Where(), error);
            }
            catch (EntryPointNotFoundException error)
            {
                throw new DllNotFoundException(FileName() + " is there, but is none of dynpoint's: " + error.Message,
                                               error);
            }
            Version wanted = new Version(Native.Version);
            if (number < ((uint)wanted.Major << 16 | (uint)wanted.Minor << 8))
                throw new DllNotFoundException(FileName() + " has the number " + number.ToString("x6")
                                               + ": it is older than " + Native.Version + ", as these sources are");
            isThere = true;
        }

        private static string FileName()
        {
            if (Path.DirectorySeparatorChar == '\\') return Native.Name + ".dll";
            return "lib" + Native.Name + (Directory.Exists("/System/Library") ? ".dylib" : ".so");
        }

        private static string Where()
        {
            string place = typeof(Library).Assembly.Location; // "" where the assembly is part of the program
            string folder = string.IsNullOrEmpty(place) ? "the program's folder" : Path.GetDirectoryName(place);
            string variable = Path.DirectorySeparatorChar == '\\' ? "PATH"
                : Directory.Exists("/System/Library") ? "DYLD_LIBRARY_PATH" : "LD_LIBRARY_PATH";
            return FileName() + " cannot be loaded. It is looked for beside this assembly, in " + folder + ", then in "
                + variable + " (" + (Environment.GetEnvironmentVariable(variable) ?? "not set")
                + ") and in the system's folders. `make csharp` builds it. In Unity it belongs into"
                + " Plugins of the package, in a project of .NET into runtimes/RID/native. If it is there, it may be for"
                + " another processor, or lack a library of its own.";
        }
    }
}
