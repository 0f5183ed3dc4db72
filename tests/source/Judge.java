import java.io.File;
import javax.xml.transform.stream.StreamSource;
import javax.xml.validation.Schema;
import javax.xml.validation.SchemaFactory;
import org.xml.sax.SAXException;

/** Judges files by a schema with the JDK's own validator: `java Judge.java SCHEMA FILE...` prints a line for each. */
public class Judge {
    public static void main(String[] arguments) throws Exception {
        SchemaFactory factory = SchemaFactory.newInstance("http://www.w3.org/2001/XMLSchema");
        Schema schema = factory.newSchema(new File(arguments[0]));
        for (int i = 1; i < arguments.length; i++) {
            try {
                schema.newValidator().validate(new StreamSource(new File(arguments[i])));
                System.out.println("valid " + arguments[i]);
            } catch (SAXException fault) {
                System.out.println("invalid " + arguments[i] + ": " + fault.getMessage());
            }
        }
    }
}
