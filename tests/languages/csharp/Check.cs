// SPDX-License-Identifier: BSD-3-Clause
// Tests of the package of C#: Tests.exe LAYOUTS prints "ok WHAT" or "FAIL WHAT", a line a check
// (tests/languages/check.sh).
using System;
using System.Text.RegularExpressions;
using Dynpoint;

static class Check
{
    static int failed;

    public static void That(bool isSo, string what, params object[] seen)
    {
        if (!isSo) failed++;
        string text = string.Format(System.Globalization.CultureInfo.InvariantCulture, what, seen);
        Console.WriteLine((isSo ? "ok " : "FAIL ") + text.Replace('\n', ' '));
    }

    /// <summary>The call throws this kind of exception, and its text has all these words.</summary>
    public static void Throws<T>(Action call, string what, params string[] words) where T : Exception
    {
        string said = "nothing was thrown";
        bool isSo = false;
        try
        {
            call();
        }
        catch (Exception error)
        {
            said = error.GetType().Name + ": " + error.Message;
            isSo = error is T && Array.TrueForAll(words, word => error.Message.Contains(word));
        }
        That(isSo, "{0} ({1})", what, said);
    }

    public static void Refuses(Result result, Action call, string what, params string[] words)
    {
        Throws<DynpointException>(call, what, words);
        try
        {
            call();
        }
        catch (DynpointException error)
        {
            if (error.Result != result) That(false, "{0}: {1}, not {2}", what, error.Result, result);
        }
    }

    /// <summary>What C# thinks of the structs, beside tests/abi/layouts.txt, which the C compiler is held to.</summary>
    static void LayoutsAreTheLibrarys(string path)
    {
        var told = new System.Collections.Generic.HashSet<string>();
        Layouts.Tell(line => told.Add(line));
        int found = 0;
        string listed = System.IO.File.ReadAllText(path), missing = "";
        foreach (Match match in Regex.Matches(listed, @"^(FIELD|SIZE|VALUE)\((\w+), *([^)]*)\)", RegexOptions.Multiline))
        {
            string[] rest = Regex.Split(match.Groups[3].Value, ", *");
            string kind = match.Groups[1].Value, line = kind + " " + match.Groups[2].Value + " ";
            int column = IntPtr.Size == 8 ? 0 : kind == "FIELD" ? 2 : 1;
            if (kind == "FIELD") line += rest[0] + " " + rest[1 + column] + " " + rest[2 + column];
            if (kind == "SIZE") line += rest[column];
            if (kind == "VALUE") line += rest[0].StartsWith("0x") ? Convert.ToInt64(rest[0], 16)
                : long.Parse(rest[0].TrimEnd('u', 'U'));
            if (told.Contains(line)) found++;
            else if (!line.StartsWith("VALUE DPT_RESULT_END")) missing += line + "; ";
        }
        That(missing == "" && found > 1000, "{0} places, sizes and values are those of layouts.txt {1}", found, missing);
    }

    static int Main(string[] arguments)
    {
        LayoutsAreTheLibrarys(arguments[0]);
        Feel.Run();
        Misuse.Run();
        UnityFrames.Run();
        return failed > 0 ? 2 : 0;
    }
}
