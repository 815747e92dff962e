// One program for the live page and for reports, so that what they share is there once.

import { startPage } from "./page";
import { holdsFrames } from "./stored";
import { startReport } from "./report";

if (holdsFrames()) startReport();
else startPage();
